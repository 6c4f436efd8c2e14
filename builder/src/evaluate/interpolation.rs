use super::{EvaluateError, SectionReport, Subject};
use crate::progress::Report;
pub(super) fn section(_subject: &Subject, _report: Report) -> Result<SectionReport, EvaluateError> {
    Ok(super::missing("This version does not evaluate it yet."))
}
