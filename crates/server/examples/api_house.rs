//! A server with the two-level mine and nobody in it, for tools that ask the API (`ci/schemathesis.sh`): prints its address and the token of an
//! admin, each on a line, and serves until its standard input ends.

#[path = "../tests/api/house.rs"]
#[expect(dead_code, reason = "the tests use more of it")]
mod house;

use house::{House, Tested};

#[tokio::main]
async fn main() -> Tested {
    let house = House::new().await?;
    println!("http://{}", house.address);
    println!("{}", house.token("admin"));
    tokio::task::spawn_blocking(|| std::io::copy(&mut std::io::stdin(), &mut std::io::sink())).await??;
    Ok(())
}
