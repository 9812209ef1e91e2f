"""What is drawn over the picture beside text: the time bar, and what the estimator saw."""
