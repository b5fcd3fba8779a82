"""One branch: traced, monitored, certified."""
