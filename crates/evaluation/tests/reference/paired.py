"""Paired t interval by scipy, the numbers of src/compare/paired.rs: /path/to/python paired.py"""
import scipy.stats

a = [0.31, 0.28, 0.44, 0.39, 0.25, 0.36, 0.41]
b = [0.35, 0.27, 0.52, 0.47, 0.29, 0.33, 0.55]
test = scipy.stats.ttest_rel(a, b)
low, high = test.confidence_interval(0.95)
mean = sum(x - y for x, y in zip(a, b)) / len(a)
print(f"{mean:.17g}, {low:.17g}, {high:.17g}")
