"""What commands work out besides the map."""
