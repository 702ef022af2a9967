//! What the server counts, for Prometheus.

use super::Context;
use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};
use std::sync::{Arc, OnceLock};

/// Upper ends of the bins of latencies, s.
const LATENCY_S: [f64; 14] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 5.0, 10.0];

/// The counters of this process; there is one set, however often it is asked for.
#[derive(Clone)]
pub struct Metrics {
    handle: PrometheusHandle,
}

impl Metrics {
    /// Begins to count with the macros of the crate `metrics`, or goes on. In a program that counts elsewhere already, nothing is shown.
    pub fn of_process() -> Self {
        static OF_PROCESS: OnceLock<Metrics> = OnceLock::new();
        OF_PROCESS
            .get_or_init(|| {
                let builder = PrometheusBuilder::new();
                let builder = builder.set_buckets_for_metric(Matcher::Suffix("_seconds".into()), &LATENCY_S);
                let recorder = builder.unwrap_or_else(|_| PrometheusBuilder::new()).build_recorder();
                let handle = recorder.handle();
                if metrics::set_global_recorder(recorder).is_err() {
                    tracing::warn!("metrics: this program counts elsewhere; /metrics stays empty");
                }
                Self { handle }
            })
            .clone()
    }

    /// All counters as text.
    pub fn render(&self) -> String {
        self.handle.run_upkeep();
        self.handle.render()
    }
}

/// The counters of the server as Prometheus reads them.
#[utoipa::path(get, path = "/metrics", tag = "health", responses(
    (status = 200, description = "text format 0.0.4", body = String, content_type = "text/plain"),
))]
pub(super) async fn metrics(State(context): State<Arc<Context>>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], context.metrics.render())
}
