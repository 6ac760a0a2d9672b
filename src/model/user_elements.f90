!> User elements (*USER ELEMENT) and beams by their section: their kinds, properties, unknowns and memory.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The routine UEL has force and stiffness; those of beams are in section_beams. An unknown of an element is a degree of freedom
!! of one of its nodes; degrees of freedom 4 to 6 are the displacements of the rotation node. An element keeps its SVARS and
!! eight energies at the end of user_memory.
module amontons_user_elements
  use amontons_kinds, only: DP
  implicit none
  private
  public :: user_kind_type, user_properties_type, user_element_type, user_elements_type, n_user_memory, &
    user_kind_number, user_unknowns
  public :: section_stiffness_type, has_uel
  public :: N_UEL_ENERGIES, ENERGY_ELASTIC, ENERGY_CREEP, ENERGY_PLASTIC

  integer, parameter :: N_UEL_ENERGIES = 8         !< length of ENERGY
  integer, parameter :: ENERGY_ELASTIC = 2, ENERGY_CREEP = 3, ENERGY_PLASTIC = 4   !< places in it

  !> A type of *USER ELEMENT.
  type :: user_kind_type
    integer :: number = 0                          !< n of Un, JTYPE
    integer :: n_nodes = 0
    integer :: n_coordinates = 3                   !< MCRD
    integer :: n_reals = 0, n_integers = 0         !< properties of *UEL PROPERTY
    integer :: n_svars = 1
    logical :: is_unsymmetric = .false.            !< UNSYMM
    logical :: is_beam = .false.                   !< a beam by its section, without UEL
    integer, allocatable :: node(:), dof(:)        !< (NDOFEL) of each unknown: node of the element, degree of freedom 1 to 6
    integer :: line = 0                            !< of the card in the deck, for messages
  end type user_kind_type

  !> The stiffnesses of a cross-section along its axes 1 and 2; tangent = axis 1 x axis 2.
  type :: section_stiffness_type
    real(DP) :: axial = 0                          !< E A [force]
    real(DP) :: torsion = 0                        !< G J [force length^2]
    real(DP) :: bending(2, 2) = 0                  !< moments about axes 1, 2 over the curvatures about them [force length^2]
    real(DP) :: shear(2) = 0                       !< k G A along axes 1, 2 [force]
    real(DP) :: centroid(2) = 0                    !< place of the centroid along axes 1, 2 from the node [length]
    real(DP) :: shear_center(2) = 0                !< place of the shear centre along axes 1, 2 from the node [length]
    real(DP) :: direction(3) = 0                   !< fixes axis 1 together with the tangent [-]
  end type section_stiffness_type

  !> The data of *UEL PROPERTY, or the section of beams.
  type :: user_properties_type
    real(DP), allocatable :: reals(:)              !< PROPS
    integer, allocatable :: integers(:)            !< JPROPS
    type(section_stiffness_type) :: section
  end type user_properties_type

  !> One user element.
  type :: user_element_type
    integer :: element = 0                         !< its index in the mesh
    integer :: kind = 0                            !< index into kinds
    integer :: properties = 0                      !< index into properties
    integer :: memory = 0                          !< offset of its SVARS and energies in the memory of all user elements
    integer, allocatable :: nodes(:)               !< nodes that its stiffness couples, rotation nodes included, each once
    integer, allocatable :: place(:)               !< (NDOFEL) of each unknown: 3 (index into nodes) - 3 + displacement
  end type user_element_type

  !> All user elements of a model.
  type :: user_elements_type
    type(user_kind_type), allocatable :: kinds(:)
    type(user_properties_type), allocatable :: properties(:)
    type(user_element_type), allocatable :: elements(:)
    integer :: n_memory = 0                        !< values that they keep
    logical :: has_temperature = .false.           !< the deck gives temperatures: they come first in PREDEF
  end type user_elements_type

contains

  !> Whether elements of a model need the routine UEL.
  pure logical function has_uel(user_elements)
    type(user_elements_type), allocatable, intent(in) :: user_elements
    has_uel = .false.
    if (allocated(user_elements)) has_uel = any(.not. user_elements%kinds%is_beam)
  end function has_uel


  !> The values that the user elements of a model keep; 0 without user elements.
  pure integer function n_user_memory(user_elements) result(n)
    type(user_elements_type), allocatable, intent(in) :: user_elements
    n = 0
    if (allocated(user_elements)) n = user_elements%n_memory
  end function n_user_memory


  !> The unknowns of an element among all of the model, in the order of UEL.
  pure function user_unknowns(element) result(unknowns)
    type(user_element_type), intent(in) :: element
    integer :: unknowns(size(element%place))
    integer :: k
    unknowns = [(3 * element%nodes((element%place(k) + 2) / 3) - 2 + mod(element%place(k) - 1, 3), k=1, size(element%place))]
  end function user_unknowns


  !> n of a type Un, in upper case; 0: it is no such type.
  pure integer function user_kind_number(type) result(number)
    character(*), intent(in) :: type
    integer, parameter :: MAX_NUMBER_DIGITS = 4           ! as in Abaqus
    number = 0
    if (len(type) < 2 .or. len(type) > 1 + MAX_NUMBER_DIGITS) return
    if (type(1:1) /= 'U' .or. verify(type(2:), '0123456789') > 0) return
    read (type(2:), '(i4)') number
  end function user_kind_number

end module amontons_user_elements
