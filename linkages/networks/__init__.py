"""Networks of Bennett loops whose joints are locked and released."""
