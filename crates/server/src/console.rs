//! The console: the pages of `web/dist`, in the binary.
//!
//! Pages are no part of the API: they are mounted one by one, by their names, as open to all ([`Access::Page`]), so that the log-in page
//! loads. What they show they ask of the API, as everybody else. They may load nothing from anywhere else, and no other page may frame
//! them ([`POLICY`]). Files of `assets/` have a hash of what they hold in their names: browsers keep them for good.
//!
//! [`Access::Page`]: crate::api::Access::Page

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use rust_embed::{EmbeddedFile, RustEmbed};
use sha2::{Digest as _, Sha256};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::LazyLock;

/// What a page may load, and who may frame it.
const POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; \
    connect-src 'self'; worker-src 'self' blob:; frame-ancestors 'none'";

/// Shown where the binary was built without a console.
const NONE: &str = include_str!("console/none.html");

/// A year, s.
const FOR_GOOD: &str = "public, max-age=31536000, immutable";

#[derive(RustEmbed)]
#[folder = "../../web/dist"]
#[allow_missing = true]
struct Built;

/// A file of the console, ready to be sent.
pub struct Page {
    /// Where it is asked for.
    pub path: String,
    mime: String,
    cache: &'static str,
    tag: String,
    plain: Bytes,
    zipped: Option<Bytes>,
}

/// All files of the console, compressed once.
pub fn pages() -> &'static [Page] {
    static PAGES: LazyLock<Vec<Page>> = LazyLock::new(|| {
        let names = Built::iter().filter(|name| name != "index.html");
        let files = names.filter_map(|name| Some(Page::of(&name, Built::get(&name)?)));
        let index = match Built::get("index.html") {
            Some(file) => Page::of("", file),
            None => Page::new("", "text/html".to_owned(), Bytes::from_static(NONE.as_bytes())),
        };
        std::iter::once(index).chain(files).collect()
    });
    &PAGES
}

impl Page {
    fn of(name: &str, file: EmbeddedFile) -> Self {
        let mime = file.metadata.mimetype().to_owned();
        let plain = match file.data {
            Cow::Borrowed(bytes) => Bytes::from_static(bytes),
            Cow::Owned(bytes) => Bytes::from(bytes),
        };
        Self::new(name, mime, plain)
    }

    fn new(name: &str, mime: String, plain: Bytes) -> Self {
        let text =
            mime.starts_with("text/") || ["javascript", "json", "xml"].iter().any(|t| mime.contains(t));
        let mime = if text { format!("{mime}; charset=utf-8") } else { mime };
        let zipped = text.then(|| zip(&plain)).filter(|zipped| zipped.len() < plain.len());
        let cache = if name.starts_with("assets/") { FOR_GOOD } else { "no-cache" };
        let mut tag = "\"".to_owned();
        for byte in Sha256::digest(&plain).iter().take(16) {
            // A text takes everything.
            let _ = write!(tag, "{byte:02x}");
        }
        tag.push('"');
        Self { path: format!("/{name}"), mime, cache, tag, plain, zipped }
    }

    /// The answer to who asks for it.
    pub fn answer(&self, asked: &HeaderMap) -> Response {
        let has = |name, wanted: &str| {
            let lines = asked.get_all(name).iter().filter_map(|line| line.to_str().ok());
            lines.flat_map(|line| line.split(',')).any(|part| part.trim().trim_start_matches("W/") == wanted)
        };
        let common = [
            (header::ETAG, self.tag.as_str()),
            (header::CACHE_CONTROL, self.cache),
            (header::CONTENT_SECURITY_POLICY, POLICY),
            (header::REFERRER_POLICY, "no-referrer"),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
            (header::VARY, "Accept-Encoding"),
        ];
        if has(header::IF_NONE_MATCH, &self.tag) {
            return (StatusCode::NOT_MODIFIED, common).into_response();
        }
        let kind = [(header::CONTENT_TYPE, self.mime.as_str())];
        match &self.zipped {
            Some(zipped) if takes_gzip(asked) => {
                let mut answer = (common, kind, zipped.clone()).into_response();
                answer.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
                answer
            }
            _ => (common, kind, self.plain.clone()).into_response(),
        }
    }
}

/// Whether who asks reads gzip: it is named, and not with the weight 0.
fn takes_gzip(asked: &HeaderMap) -> bool {
    let lines = asked.get_all(header::ACCEPT_ENCODING).iter().filter_map(|line| line.to_str().ok());
    lines.flat_map(|line| line.split(',')).any(|part| {
        let (coding, weight) = part.split_once(';').unwrap_or((part, ""));
        let weight = weight.trim().strip_prefix("q=").and_then(|weight| weight.parse::<f64>().ok());
        coding.trim().eq_ignore_ascii_case("gzip") && weight != Some(0.0)
    })
}

fn zip(plain: &[u8]) -> Bytes {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // Writing into memory does not fail; nothing is longer than any file, so that it is not sent.
    let zipped = encoder.write_all(plain).and_then(|()| encoder.finish());
    zipped.map_or_else(|_| Bytes::from_owner(plain.to_vec()), Bytes::from)
}
