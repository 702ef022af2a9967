//! A bare list of anchors: `anchor_id,x_m,y_m,z_m` in any order, `#` for comments. A mine with anchors only.

use super::Found;
use super::syntax::syntax;
use super::tree::{Entry, Node, Value, shown};
use crate::finding::Place;
use crate::problem::Problem;
use csv::{ReaderBuilder, StringRecord, Trim};

const COLUMNS: [&str; 4] = ["anchor_id", "x_m", "y_m", "z_m"];

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
        let expected = || COLUMNS.map(str::to_owned).to_vec();
        if !COLUMNS.contains(&name) {
            let problem = Problem::UnknownKey { key: shown(name), expected: expected() };
            found.push(Found::new(head, Place::default(), problem));
        } else if header.iter().take(index).any(|before| before == name) {
            found.push(Found::new(head, Place::default(), Problem::RepeatedKey { key: name.to_owned() }));
        }
    }
    for column in COLUMNS.iter().filter(|column| !header.iter().any(|name| name == **column)) {
        found.push(Found::new(head, Place::default(), Problem::MissingKey { key: (*column).to_owned() }));
    }
    if !found.is_empty() {
        return None;
    }
    let columns = COLUMNS.map(|column| header.iter().position(|name| name == column).unwrap_or(0));
    let mut anchors = Vec::new();
    for row in reader.records() {
        match row {
            Ok(row) => anchors.extend(anchor(&row, columns, header.len(), place(&row, bare, shift), found)),
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

fn anchor(
    row: &StringRecord,
    columns: [usize; 4],
    width: usize,
    at: usize,
    found: &mut Vec<Found>,
) -> Option<Node> {
    if row.len() != width {
        found.push(syntax(at, format!("found {} fields, expected {width}, as in the header", row.len())));
        return None;
    }
    let mut coordinates = Vec::with_capacity(3);
    for (name, column) in COLUMNS.iter().zip(columns).skip(1) {
        let field = &row[column];
        let Ok(number) = field.parse::<f64>() else {
            let found_text = Node::new(at, Value::Text(field.to_owned())).describe();
            let (key, expected) = ((*name).to_owned(), "a number".to_owned());
            let problem = Problem::WrongType { key, found: found_text, expected };
            found.push(Found::new(at, Place::default(), problem));
            return None;
        };
        coordinates.push(Node::new(at, Value::Float(number)));
    }
    let entries = vec![
        Entry::new("id", at, Node::new(at, Value::Text(row[columns[0]].to_owned()))),
        Entry::new("position_m", at, Node::new(at, Value::List(coordinates))),
    ];
    Some(Node::new(at, Value::Table(entries)))
}

/// The byte at which a record begins, empty lines and comments before it left out.
fn place(row: &StringRecord, text: &str, shift: usize) -> usize {
    let start = row.position().and_then(|p| usize::try_from(p.byte()).ok()).unwrap_or(0);
    let lines = text.get(start..).unwrap_or_default().split_inclusive('\n');
    let skipped = lines.take_while(|line| line.trim().is_empty() || line.starts_with('#'));
    shift + start + skipped.map(str::len).sum::<usize>()
}
