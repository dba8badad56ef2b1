// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/transfer_table.hpp"

namespace shearwake::layered {

/// Everything that the transfer function of the displacement, of the stress at the receptors, or
/// the loss depends on. In the periodic regime the surface is always among the depths of the
/// displacement, as the first one; the others have an empty list of depths where they are not
/// needed. Not collective.
TransferKey key_of(const Case& c, const LayeredOptions& options);
/// `displacement`: key_of() this case.
TransferKey stress_key_of(const Case& c, const TransferKey& displacement);
/// Without depths if the case does not request the tangential displacement.
TransferKey tangential_key_of(const Case& c, const TransferKey& displacement);
TransferKey loss_key_of(const Case& c, const TransferKey& displacement);

/// Number of frames whose spectra are in memory at the same time, on a rank with ky_count rows. Not
/// collective.
std::ptrdiff_t frames_per_batch(const Case& c, std::ptrdiff_t ky_count);

/// Adds the work of a table to the progress of a case, on a rank with ky_count rows of a team of
/// `ranks`. Not collective.
void expect_table(CaseProgress& progress, const TransferKey& key, std::ptrdiff_t ky_count,
                  int ranks);
/// Adds the work of the frames of this rank. Not collective.
void expect_frames(CaseProgress& progress, const Case& c, const TransferKey& key,
                   std::ptrdiff_t ky_count, int ranks);

} // namespace shearwake::layered
