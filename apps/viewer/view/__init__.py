"""A look-dev viewer in the browser: a mesh drawn by OpenGL, shaded by Pellucid, tuned while one looks.

``python -m pellucid.view [MESH]`` opens it. The parts stand alone as well: `renderer` is a deferred renderer
in OpenGL 3.3 whose images Pellucid takes where they are, `session` shades them, `export` writes what
`pellucid shade` reads.
"""
