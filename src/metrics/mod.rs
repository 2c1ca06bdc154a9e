//! stub
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricId {
    SeamSpeed,
}
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    pub id: MetricId,
    pub label: &'static str,
    pub value: Option<f64>,
    pub unit: &'static str,
    pub help: &'static str,
}
impl Metric {
    pub fn format(&self) -> String {
        String::new()
    }
}
pub struct TransitionMetrics;
