"""The jobs that ask the other way round: what to improve, and which camera a part needs."""
