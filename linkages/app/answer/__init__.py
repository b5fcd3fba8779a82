"""What an atlas says of its linkage: verdict, mobility, configurations, the document.

An atlas goes in; sentences, numbers in the units of the screen and the JSON document come
out.
"""
