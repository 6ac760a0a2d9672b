!> Materials: the parameters of a material as the user gave them; no formulas.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_materials
  use amontons_kinds, only: DP
  implicit none
  private
  public :: material_type, LAW_HENCKY, LAW_SAINT_VENANT

  integer, parameter :: LAW_HENCKY = 1          !< Kirchhoff stress linear in the logarithmic strain (abaqus dialect)
  integer, parameter :: LAW_SAINT_VENANT = 2    !< 2nd Piola-Kirchhoff stress linear in the Green strain (calculix dialect)

  !> One material. Under small displacements every law is Hooke's.
  type :: material_type
    character(:), allocatable :: name
    integer :: law = LAW_HENCKY                 !< law at finite strain, chosen by the dialect
    logical :: has_elastic = .false.
    real(DP) :: youngs_modulus = 0              !< E [stress]
    real(DP) :: poissons_ratio = 0              !< nu [-]
    logical :: has_density = .false.
    real(DP) :: density = 0                     !< rho [mass/volume]
  end type material_type

end module amontons_materials
