"""Forms and routes for other programs: animated models, tables of joint angles."""
