"""The parts of render_gbuffer.py, one file each."""
