"""Scene of results in one HTML page: stage, field and deformation are switched in the page."""
