"""Links with real joints, as parts that a printer makes: their dimensions, where joints
sit so that nothing meets along a form, and the solids."""
