"""The jobs with images: simulate them, measure in them, validate the law of the error by them."""
