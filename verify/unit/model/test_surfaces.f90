!> Unit test of amontons_surfaces: which laws are compliant, and the laws of pairs.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_surfaces
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type, contact_pair_type, is_compliant, pair_interactions, BEHAVIOR_HARD, &
    BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, BEHAVIOR_USER, NO_SHEAR_LIMIT, ROUGH_FRICTION
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_compliant()
  call check_pairs()
  call suite%finish()

contains

  !> HARD alone is exact.
  subroutine check_compliant()
    type(interaction_type) :: laws(6)
    laws%behavior = [BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, BEHAVIOR_USER]
    call suite%that('compliant', all(is_compliant(laws) .eqv. [.false., .true., .true., .true., .true., .true.]))
    call suite%that('defaults', laws(1)%friction == 0 .and. laws(1)%shear_limit == NO_SHEAR_LIMIT)
    call suite%that('limits do not overflow', ROUGH_FRICTION * NO_SHEAR_LIMIT < huge(1.0_DP))
  end subroutine check_compliant


  !> A LINEAR law of a mortar pair has no tension and nearly no reach; all others stay.
  subroutine check_pairs()
    type(interaction_type) :: interactions(2), laws(3)
    type(contact_pair_type) :: pairs(3)
    interactions%behavior = [BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL]
    interactions%tension_limit = 5
    interactions%cutoff_clearance = 0.5_DP
    interactions%stiffness = [100.0_DP, 200.0_DP]
    pairs%interaction = [1, 1, 2]
    pairs%is_mortar = [.false., .true., .true.]
    laws = pair_interactions(pairs, interactions)
    call suite%that('by index', all(laws%stiffness == [100.0_DP, 100.0_DP, 200.0_DP]))
    call suite%that('tension', all(laws%tension_limit == [5.0_DP, 0.0_DP, 5.0_DP]))
    call suite%that('reach', laws(1)%cutoff_clearance == 0.5_DP .and. laws(2)%cutoff_clearance < 1.0e-6_DP &
      .and. laws(3)%cutoff_clearance == 0.5_DP)
  end subroutine check_pairs

end program test_surfaces
