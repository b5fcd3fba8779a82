"""Mechanisms of several loops and of every kind of joint."""
