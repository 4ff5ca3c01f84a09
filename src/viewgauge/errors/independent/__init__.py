"""The 1998 model: ratios of normal variables at each end, added as independent errors."""
