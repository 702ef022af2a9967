//! Mine files: bytes in, a mine and everything that is wrong with it out, each with its line.
//!
//! | form | told by | read | written |
//! |---|---|---|---|
//! | TOML, for people | none of the others | yes | [`to_toml`] |
//! | JSON, the same keys | `{` first | yes | [`to_json`] |
//! | `GeoJSON`, for maps | `"type": "FeatureCollection"` | yes | [`to_geojson`] |
//! | CSV of anchors alone | a column `anchor_id` in the first line that is no comment | yes | – |
//!
//! All forms become one tree of values that know where they stood; its shape is held against the JSON Schema of
//! [`MinePlan`](crate::plan::MinePlan), which is [`schema`]; the rest is [`check`](crate::check()). What is wrong in one entry hides nothing in
//! another: everything is told at once, in order of line.

mod anchors_csv;
mod geojson;
mod notice;
mod shape;
mod syntax;
mod tree;
mod typed;
mod write;

pub use notice::Notice;
pub use shape::schema;
pub use write::{to_geojson, to_json, to_toml};

use crate::check::inspect;
use crate::error::MineError;
use crate::finding::{Finding, Place, Severity};
use crate::mine::Mine;
use crate::problem::Problem;
use notice::Lines;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

/// A mine of a thousand kilometres takes a third of it, bytes.
pub const LARGEST: u64 = 16 << 20;

/// In what form a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// TOML.
    Toml,
    /// JSON with the keys of the TOML form.
    Json,
    /// `GeoJSON`, a feature for each entry.
    GeoJson,
    /// Anchors alone, CSV.
    AnchorsCsv,
}

/// What became of a file.
#[derive(Debug)]
pub struct Checked {
    /// The form it is in.
    pub form: Form,
    /// All that is wrong with it, in order of line.
    pub notices: Vec<Notice>,
    /// The mine; `None` when there is an error among the notices.
    pub mine: Option<Mine>,
}

impl Checked {
    /// Errors, in order of line.
    pub fn errors(&self) -> impl Iterator<Item = &Notice> {
        self.notices.iter().filter(|notice| notice.severity() == Severity::Error)
    }

    /// Warnings, in order of line.
    pub fn warnings(&self) -> impl Iterator<Item = &Notice> {
        self.notices.iter().filter(|notice| notice.severity() == Severity::Warning)
    }
}

/// Something wrong, by the byte where it stands.
struct Found {
    at: usize,
    finding: Finding,
}

impl Found {
    fn new(at: usize, place: Place, problem: Problem) -> Self {
        Self { at, finding: Finding { place, problem } }
    }
}

/// Reads and checks a file; an error only when it cannot be read at all.
pub fn check(path: &Path) -> Result<Checked, MineError> {
    let io = |source| MineError::Io { file: path.to_path_buf(), source };
    let mut bytes = Vec::new();
    File::open(path).map_err(io)?.take(LARGEST + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > LARGEST {
        return Err(MineError::TooLarge { file: path.to_path_buf(), limit: LARGEST });
    }
    Ok(parse(path, &bytes))
}

/// Reads a mine to work with; its warnings come with it.
pub fn open(path: &Path) -> Result<(Mine, Vec<Notice>), MineError> {
    let Checked { mut notices, mine, .. } = check(path)?;
    if let Some(mine) = mine {
        return Ok((mine, notices));
    }
    notices.retain(|notice| notice.severity() == Severity::Error);
    Err(MineError::Invalid { file: path.to_path_buf(), notices })
}

/// Checks the bytes of a file; `file` is its name in messages.
pub fn parse(file: &Path, bytes: &[u8]) -> Checked {
    let lines = Lines::new(Arc::from(file), bytes);
    let form = form(bytes);
    let mut found = Vec::new();
    let tree = syntax::read(form, bytes, &mut found);
    let Some(tree) = tree.filter(|_| found.is_empty()) else {
        return Checked { form, notices: lines.notices(None, found), mine: None };
    };
    let tree = if form == Form::GeoJson { geojson::to_plan(tree, &mut found) } else { tree };
    shape::walk(&tree, &mut found);
    let typed = typed::read(&tree, &mut found);
    let plan = typed.plan.canonical();
    let (findings, survey) = inspect(&plan, &typed.unread);
    found.extend(findings.into_iter().map(|finding| {
        let place = typed.kept.original(finding.place);
        Found { at: tree.find(&place), finding: Finding { place, ..finding } }
    }));
    let notices = lines.notices(Some(&tree), found);
    let sound = notices.iter().all(|notice| notice.severity() != Severity::Error);
    let mine = survey.filter(|_| sound).map(|survey| Mine::from_survey(plan, survey));
    Checked { form, notices, mine }
}

/// The form of a file, by its content.
fn form(bytes: &[u8]) -> Form {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = text.trim_ascii_start();
    let mut lines = start.split(|b| *b == b'\n');
    let first_line = lines.find(|line| !line.trim_ascii().is_empty() && line[0] != b'#').unwrap_or_default();
    if start.first() == Some(&b'{') {
        if syntax::is_feature_collection(bytes) { Form::GeoJson } else { Form::Json }
    } else if first_line.split(|b| *b == b',').any(|name| name.trim_ascii() == b"anchor_id") {
        Form::AnchorsCsv
    } else {
        Form::Toml
    }
}
