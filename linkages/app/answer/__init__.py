"""What an atlas says of its linkage: verdict, mobility, configurations, the JSON document."""
