//! The console's pages, as a browser asks for them.

use crate::house::{House, Tested};
use flate2::read::GzDecoder;
use std::io::Read as _;

#[tokio::test]
async fn a_page_comes_packed_to_those_who_read_gzip_and_once_to_those_who_have_it() -> Tested {
    let house = House::new().await?;
    let client = reqwest::Client::new();
    let ask = |name: &'static str, value: String| client.get(house.url("/")).header(name, value);
    let plain = client.get(house.url("/")).send().await?;
    assert_eq!(plain.headers()["cache-control"], "no-cache");
    assert!(!plain.headers().contains_key("content-encoding"));
    let tag = plain.headers()["etag"].to_str()?.to_owned();
    let plain = plain.text().await?;
    assert!(plain.to_lowercase().starts_with("<!doctype html>"), "{plain}");

    let packed = ask("accept-encoding", "br, gzip;q=0.8".into()).send().await?;
    assert_eq!(packed.headers()["content-encoding"], "gzip");
    let mut text = String::new();
    GzDecoder::new(&packed.bytes().await?[..]).read_to_string(&mut text)?;
    assert_eq!(text, plain);
    let refused = ask("accept-encoding", "gzip;q=0".into()).send().await?;
    assert!(!refused.headers().contains_key("content-encoding"));

    let known = ask("if-none-match", tag).send().await?;
    assert_eq!((known.status().as_u16(), known.bytes().await?.len()), (304, 0));
    Ok(())
}

#[tokio::test]
async fn the_console_that_was_built_is_the_one_that_is_served() -> Tested {
    let built = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist/index.html");
    let Ok(expected) = std::fs::read_to_string(built) else {
        println!("SKIPPED (no test data): the console, which npm builds (make console)");
        return Ok(());
    };
    let house = House::new().await?;
    assert_eq!(reqwest::get(house.url("/")).await?.text().await?, expected);
    Ok(())
}

#[tokio::test]
async fn other_sites_may_link_to_the_console_but_not_log_in() -> Tested {
    let house = House::new().await?;
    let client = reqwest::Client::new();
    let page = client.get(house.url("/")).header("sec-fetch-site", "cross-site").send().await?;
    assert_eq!(page.status(), 200);
    let login = client.post(house.url("/api/v1/session")).header("sec-fetch-site", "cross-site");
    assert_eq!(login.send().await?.status(), 403);
    assert_eq!(client.post(house.url("/")).send().await?.status(), 401, "a page is read, nothing else");
    Ok(())
}
