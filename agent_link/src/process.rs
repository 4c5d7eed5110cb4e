//! What every program of the project does around its loop.

use std::io;

use tokio::runtime::{Builder, Runtime};

/// zenoh blocks a worker now and then, for as long as a network stands still; with these there is
/// one left for the machine.
const MIN_WORKERS: usize = 4;

/// The runtime that sessions and machines need: of several threads, on any number of processors.
pub fn runtime() -> io::Result<Runtime> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    Builder::new_multi_thread()
        .worker_threads(processors.max(MIN_WORKERS))
        .enable_all()
        .build()
}

/// Returns when the process is asked to end, by Ctrl-C or by the system.
pub async fn interrupted() {
    let ctrl_c = async {
        if let Err(error) = tokio::signal::ctrl_c().await {
            tracing::warn!("cannot listen for Ctrl-C: {error}");
            std::future::pending::<()>().await;
        }
    };
    tokio::select! {
        () = ctrl_c => {}
        () = terminated() => {}
    }
}

/// Returns when the standard input has ended, which it does when the process that holds its other
/// end is gone, however it went.
pub async fn stdin_ended() {
    let (ended, end) = tokio::sync::oneshot::channel();
    // A thread of its own: nothing can interrupt a read of the standard input, and a runtime would
    // wait for it at the end.
    let reading = std::thread::Builder::new().spawn(move || {
        let mut stdin = io::stdin().lock();
        let _ = io::copy(&mut stdin, &mut io::sink());
        let _ = ended.send(());
    });
    if let Err(error) = reading {
        tracing::warn!("cannot watch the standard input: {error}");
        return std::future::pending().await;
    }
    let _ = end.await;
}

#[cfg(unix)]
async fn terminated() {
    use tokio::signal::unix::{SignalKind, signal};
    match signal(SignalKind::terminate()) {
        Ok(mut terminate) => {
            terminate.recv().await;
        }
        Err(error) => {
            tracing::warn!("cannot listen for the signal to end: {error}");
            std::future::pending::<()>().await;
        }
    }
}

#[cfg(not(unix))]
async fn terminated() {
    std::future::pending::<()>().await;
}
