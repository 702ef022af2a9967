//! `adit serve`: the server of one mine, until somebody stops it.

mod file;

use crate::args::ServeArgs;
use crate::interrupt;
use crate::output;
use adit_server::Server;
use anyhow::{Context, Result};
use std::time::Duration;

/// How often Ctrl-C is looked for.
const PULSE: Duration = Duration::from_millis(100);

/// Serves until Ctrl-C.
pub fn run(args: &ServeArgs) -> Result<()> {
    let (settings, serving) = file::settings(args)?;
    let (site, data) = (settings.site.clone(), settings.data.clone());
    let secure = serving.tls.is_some();
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().context("no runtime")?;
    runtime.block_on(async {
        let mut server = Server::start(settings, serving).await?;
        let scheme = if secure { "https" } else { "http" };
        output::print(&format!(
            "{site}: {scheme}://{} keeps everything in {}\n",
            server.address,
            data.display()
        ))?;
        if let Some(password) = &server.first_password {
            output::print(&format!("user admin, password {password}: it is not shown again\n"))?;
        }
        let ended = tokio::select! {
            ended = server.served() => ended,
            () = interrupted() => Ok(()),
            () = stdin_ended(args.while_stdin) => Ok(()),
        };
        server.stop().await;
        Ok(ended?)
    })
}

/// Ready once somebody has asked to stop.
async fn interrupted() {
    while interrupt::check().is_ok() {
        tokio::time::sleep(PULSE).await;
    }
}

/// Ready once stdin has ended; never, where that is not asked for.
async fn stdin_ended(asked: bool) {
    let (ended, end) = tokio::sync::oneshot::channel::<()>();
    if asked {
        // A thread of its own: a read from stdin cannot be given up, and must not hold the runtime.
        std::thread::spawn(move || {
            let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
            drop(ended);
        });
        let _ = end.await;
    } else {
        std::future::pending::<()>().await;
    }
}
