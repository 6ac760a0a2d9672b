!> Unit test of amontons_element_drafts: lengths and defaults after growth and cut.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_element_drafts
  use amontons_kinds, only: DP
  use amontons_element_drafts, only: element_draft_type, resize_draft
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(element_draft_type) :: draft

  call resize_draft(draft, 4)
  call suite%that('lengths', size(draft%label) == 4 .and. size(draft%first) == 5 .and. size(draft%directions, 2) == 4)
  call suite%that('no element yet', draft%n == 0 .and. draft%first(1) == 1)
  draft%n = 2
  draft%label(:2) = [7, 9]
  draft%first(:3) = [1, 5, 9]
  draft%section_value(2) = 0.25_DP
  draft%is_rigid(2) = .true.
  draft%directions(:, 1) = [3, 2]
  draft%n_layers(1) = 3
  call resize_draft(draft, 5)
  call suite%that('kept', all(draft%label(:2) == [7, 9]) .and. all(draft%first(:3) == [1, 5, 9]) .and. draft%is_rigid(2) .and. &
    all(draft%directions(:, 1) == [3, 2]) .and. draft%n_layers(1) == 3)
  call suite%near('value kept', draft%section_value(2), 0.25_DP, 0.0_DP)
  call suite%that('new ones have no section', all(draft%material(3:) == 0) .and. all(draft%section_card(3:) == 0) .and. &
    all(draft%n_layers(3:) == 1) .and. .not. any(draft%is_rigid(3:)) .and. all(draft%spring(3:) == 0))
  call suite%near('new ones have thickness one', draft%section_value(5), 1.0_DP, 0.0_DP)
  call resize_draft(draft, draft%n)
  call suite%that('cut', size(draft%label) == 2 .and. size(draft%first) == 3 .and. draft%label(2) == 9)
  call suite%finish()
end program test_element_drafts
