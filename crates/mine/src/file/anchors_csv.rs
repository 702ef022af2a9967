//! A bare list of anchors: `anchor_id,x_m,y_m,z_m` in any order, `range_offset_m` where it is known, `#` for comments. A mine with anchors only.

use super::Found;
use super::syntax::syntax;
use super::tree::{Entry, Node, Value, shown};
use crate::finding::Place;
use crate::problem::Problem;
use csv::{ReaderBuilder, StringRecord, Trim};

const COLUMNS: [&str; 4] = ["anchor_id", "x_m", "y_m", "z_m"];
/// What an anchor adds to every range; the second is what the set uwb-imu-walk calls it. A field may be empty.
const OFFSETS: [&str; 2] = ["range_offset_m", "sfuise_range_offset_m"];

/// The tree of a plan with these anchors on a local grid.
pub fn read(text: &str, found: &mut Vec<Found>) -> Option<Node> {
    let bare = text.strip_prefix('\u{feff}').unwrap_or(text);
    let shift = text.len() - bare.len();
    let mut reader =
        ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).flexible(true).from_reader(bare.as_bytes());
    let header = match reader.headers() {
        Ok(header) => header.clone(),
        Err(error) => {
            found.push(syntax(0, error.to_string()));
            return None;
        }
    };
    let head = place(&header, bare, shift);
    for (index, name) in header.iter().enumerate() {
        let expected = || COLUMNS.iter().chain(&OFFSETS[..1]).map(|name| (*name).to_owned()).collect();
        let (offset, before) = (OFFSETS.contains(&name), header.iter().take(index));
        if !COLUMNS.contains(&name) && !offset {
            let problem = Problem::UnknownKey { key: shown(name), expected: expected() };
            found.push(Found::new(head, Place::default(), problem));
        } else if before.into_iter().any(|before| before == name || (offset && OFFSETS.contains(&before))) {
            found.push(Found::new(head, Place::default(), Problem::RepeatedKey { key: name.to_owned() }));
        }
    }
    for column in COLUMNS.iter().filter(|column| !header.iter().any(|name| name == **column)) {
        found.push(Found::new(head, Place::default(), Problem::MissingKey { key: (*column).to_owned() }));
    }
    if !found.is_empty() {
        return None;
    }
    let columns = Columns {
        needed: COLUMNS.map(|column| header.iter().position(|name| name == column).unwrap_or(0)),
        offset: header.iter().position(|name| OFFSETS.contains(&name)),
        width: header.len(),
    };
    let mut anchors = Vec::new();
    for row in reader.records() {
        match row {
            Ok(row) => anchors.extend(anchor(&row, &columns, place(&row, bare, shift), found)),
            Err(error) => {
                let at = error.position().map_or(0, |p| usize::try_from(p.byte()).unwrap_or(0));
                found.push(syntax(shift + at, error.to_string()));
                break;
            }
        }
    }
    let text = |value: &str| Node::new(0, Value::Text(value.to_owned()));
    let grid = Node::new(0, Value::Table(vec![Entry::new("kind", 0, text("local"))]));
    let plan = vec![
        Entry::new("name", 0, text("anchors")),
        Entry::new("grid", 0, grid),
        Entry::new("anchors", 0, Node::new(0, Value::List(anchors))),
    ];
    found.is_empty().then_some(Node::new(0, Value::Table(plan)))
}

/// Where everything stands in a row.
struct Columns {
    /// Of [`COLUMNS`].
    needed: [usize; 4],
    offset: Option<usize>,
    width: usize,
}

fn anchor(row: &StringRecord, columns: &Columns, at: usize, found: &mut Vec<Found>) -> Option<Node> {
    let Columns { needed, offset, width } = columns;
    if row.len() != *width {
        found.push(syntax(at, format!("found {} fields, expected {width}, as in the header", row.len())));
        return None;
    }
    let mut number = |name: &str, field: &str| {
        let Ok(number) = field.parse::<f64>() else {
            let found_text = Node::new(at, Value::Text(field.to_owned())).describe();
            let (key, expected) = (name.to_owned(), "a number".to_owned());
            let problem = Problem::WrongType { key, found: found_text, expected };
            found.push(Found::new(at, Place::default(), problem));
            return None;
        };
        Some(Node::new(at, Value::Float(number)))
    };
    let mut coordinates = Vec::with_capacity(3);
    for (name, column) in COLUMNS.iter().zip(needed).skip(1) {
        coordinates.push(number(name, &row[*column])?);
    }
    let mut entries = vec![
        Entry::new("id", at, Node::new(at, Value::Text(row[needed[0]].to_owned()))),
        Entry::new("position_m", at, Node::new(at, Value::List(coordinates))),
    ];
    if let Some(field) = offset.map(|column| &row[column]).filter(|field| !field.is_empty()) {
        entries.push(Entry::new(OFFSETS[0], at, number(OFFSETS[0], field)?));
    }
    Some(Node::new(at, Value::Table(entries)))
}

/// The byte at which a record begins, empty lines and comments before it left out.
fn place(row: &StringRecord, text: &str, shift: usize) -> usize {
    let start = row.position().and_then(|p| usize::try_from(p.byte()).ok()).unwrap_or(0);
    let lines = text.get(start..).unwrap_or_default().split_inclusive('\n');
    let skipped = lines.take_while(|line| line.trim().is_empty() || line.starts_with('#'));
    shift + start + skipped.map(str::len).sum::<usize>()
}
