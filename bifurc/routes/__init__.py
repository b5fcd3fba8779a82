"""Routes from one configuration to another, along forms and over surfaces."""
