"""Links with real joints, as parts that a printer makes.

A form and a diameter go in; seats of the joints come out such that nothing meets along
the form, and the solids as STL or STEP.
"""
