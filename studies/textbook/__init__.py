"""Problems of textbooks and continuation codes, with the points that their sources print."""
