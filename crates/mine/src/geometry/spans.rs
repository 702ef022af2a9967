//! Parts of a line, and what they cover together.

/// A part of a segment, as shares of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

impl Span {
    /// The whole segment.
    pub const WHOLE: Self = Self { from: 0.0, to: 1.0 };

    /// The part in which `start + slope t` lies between `low` and `high`.
    pub fn where_between(self, start: f64, slope: f64, low: f64, high: f64) -> Option<Self> {
        if slope == 0.0 {
            return (low..=high).contains(&start).then_some(self);
        }
        let (first, last) = ((low - start) / slope, (high - start) / slope);
        let (first, last) = if first <= last { (first, last) } else { (last, first) };
        self.clipped(first, last)
    }

    /// The part between two shares.
    pub fn clipped(self, from: f64, to: f64) -> Option<Self> {
        let part = Self { from: self.from.max(from), to: self.to.min(to) };
        (part.from <= part.to).then_some(part)
    }
}

/// The share of the segment that the spans cover together.
pub fn covered(spans: &mut [Span]) -> f64 {
    spans.sort_by(|a, b| a.from.total_cmp(&b.from));
    let (sum, _) = spans.iter().fold((0.0, 0.0_f64), |(sum, reached), span| {
        let new = span.to.min(1.0) - span.from.max(reached);
        (sum + new.max(0.0), reached.max(span.to))
    });
    sum
}
