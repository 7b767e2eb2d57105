"""What a study keeps: folders, journals, recordings and names of participants."""
