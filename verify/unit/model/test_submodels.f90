!> Unit test of amontons_submodels: the defaults are those of Abaqus.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_submodels
  use amontons_submodels, only: submodel_type, DEFAULT_EXTERIOR_TOLERANCE
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(submodel_type) :: submodel
  call suite%near('exterior tolerance', submodel%exterior_tolerance, 0.05d0, 1.0d-15)
  call suite%near('its constant', DEFAULT_EXTERIOR_TOLERANCE, submodel%exterior_tolerance, 0.0d0)
  call suite%that('no absolute one', submodel%absolute_tolerance > 1.0d300)
  call suite%that('nodes outside are errors', submodel%is_exterior_error)
  call suite%that('all global elements count', .not. allocated(submodel%global_labels))
  call suite%finish()
end program test_submodels
