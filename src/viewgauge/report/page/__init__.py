"""The pages: the report of a plan, what to improve, one chart; each an HTML text that works offline."""
