"""What a user can have done, one file a verb: load, check, evaluate, plan, improve, simulate, measure, write, ..."""
