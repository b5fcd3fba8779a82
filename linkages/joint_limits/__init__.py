"""What limits of joints cut off, keep out and leave."""
