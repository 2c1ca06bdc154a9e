//! Small skeletons with the naming conventions and proportions of common rigs, and motions for them.
