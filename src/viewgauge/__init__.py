"""Plan camera poses that measure every toleranced dimension of a part accurately enough."""
