!> Unit test of amontons_embeddings: the tolerances of a card that gives none.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_embeddings
  use amontons_kinds, only: DP
  use amontons_embeddings, only: embedding_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(embedding_type) :: embedding
  call suite%near('of a node outside', embedding%exterior_tolerance, 0.05_DP, 0.0_DP)
  call suite%that('no distance', embedding%absolute_tolerance >= huge(1.0_DP))
  call suite%near('of weights', embedding%roundoff_tolerance, 1.0e-6_DP, 0.0_DP)
  call suite%that('no elements', .not. (allocated(embedding%elements) .or. allocated(embedding%hosts)))
  call suite%finish()
end program test_embeddings
