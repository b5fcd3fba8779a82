"""What an atlas says in the variables of joints and in places of bodies."""
