"""Forms and routes for other programs: animated models, tables of joint angles.

An atlas and a form or a route go in; a glTF model or a CSV table comes out.
"""
