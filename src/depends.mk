# The floors, bottom-up: an object file and the objects of the modules that it uses.
# Kept by hand; `make lint` proves it against the use lines (upward, stale, missing).
