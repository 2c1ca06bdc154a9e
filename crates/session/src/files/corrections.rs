//! Clips of an improbable size or with improbable rows, and the options by which they are read
//! better.

use super::messages::MAX_NAMED;
use crate::library::{Library, Origin};
use crate::notice::Notices;
use crate::outside;
use segue_formats::ImportOptions;
use segue_text::{Message, msg};

/// Warns of clips that can be read better, together with those of an earlier warning.
pub(super) fn offer_corrections(
    library: &Library,
    notices: &mut Notices,
    text: Message,
    clips: Vec<String>,
) {
    let mut all = notices.take_offer();
    all.retain(|id| !clips.contains(id));
    let is_alone = all.is_empty();
    all.extend(clips);
    let text = if is_alone {
        text
    } else {
        let names = all.iter().filter_map(|id| Some(library.get(id)?.name.as_str()));
        let mut named: Vec<String> = names.take(MAX_NAMED).map(outside::short).collect();
        if all.len() > named.len() {
            named.push("…".to_owned());
        }
        msg!(
            "{count} clips have a size or position that cannot be right: {named}.",
            count = all.len()
        )
    };
    notices.offer(text, all);
}

/// Returns the options by which a clip is read better; `None` where there are none that are safe.
pub(super) fn corrected_options(library: &Library, id: &str) -> Option<ImportOptions> {
    let entry = library.get(id)?;
    let (Origin::File(file), Some(about)) = (&entry.origin, &entry.about) else {
        return None;
    };
    let options = ImportOptions {
        metres_per_unit: about.fitting_unit.or(file.options.metres_per_unit),
        even_wild_rows: about.wild_rows || file.options.even_wild_rows,
        ..file.options
    };
    (options != file.options).then_some(options)
}
