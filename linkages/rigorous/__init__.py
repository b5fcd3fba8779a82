"""Transition maps that are proved: from an atlas to a certificate, which
`linkages.rigorous.check` checks, alone and in ball arithmetic."""
