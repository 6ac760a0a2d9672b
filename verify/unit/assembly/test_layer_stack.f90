!> Unit test of amontons_layer_stack: the stiffness of the bubble against that of one solid, by hand; layers share it.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_layer_stack
  use amontons_deck, only: read_deck_text
  use amontons_element_integration_points, only: integration_points_type
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_kinds, only: DP
  use amontons_layer_stack, only: is_stacked_triangle, load_stack_bending
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,0,0;3,0,2,0;*ELEMENT, TYPE=S3, ELSET=E;1,1,2,3;*MATERIAL, NAME=M;' // &
    '*ELASTIC;91.,0.3;*MATERIAL, NAME=S;*ELASTIC;9.1,0.3;*MATERIAL, NAME=W;*ELASTIC, TYPE=ENGINEERING CONSTANTS;' // &
    '100.,1.,1.,0,0,0,2.,2.;2.;'
  type(suite_type) :: suite
  call check_even()
  call check_sandwich()
  call check_turned()
  call check_whole()
  call suite%finish()

contains

  !> E/(1 - nu^2) = 100, shear modulus 35; legs of 2, area 2, slopes of 4/3 times the bubble 3/2: their mean squares are 6/4,
  !! that of their product 3/4. Thickness 1: 12 D = 100, over both faces 4 D.
  subroutine check_even()
    real(DP) :: K(2, 2, 5)
    real(DP), parameter :: ENERGY = 2 * 0.25_DP**2 * 4 / 12.0_DP   ! area, G^i over 2 twice, 4 D over Q
    integer :: l
    call find_stiffness('.2,,M;.2,,M;.2,,M;.2,,M;.2,,M;', K)
    do l = 1, 5                                    ! amplitudes of a layer are those of the stack times its share of the thickness
      call suite%near('even: 11', K(1, 1, l), 5 * ENERGY * 4 * (100 * 1.5_DP + 35 * 1.5_DP), 1.0e-11_DP)
      call suite%near('even: 22', K(2, 2, l), K(1, 1, l), 1.0e-11_DP)
      call suite%near('even: 12', K(1, 2, l), 5 * ENERGY * 4 * 65 * 0.75_DP, 1.0e-11_DP)
    end do
  end subroutine check_even


  !> Layers of a sandwich: that of the two materials about the neutral surface, which is not in the middle.
  subroutine check_sandwich()
    real(DP) :: even(2, 2, 5), K(2, 2, 5), neutral, bending
    call find_stiffness('1.,,M;', even, 1)
    call find_stiffness('.5,,M;.5,,M;', even)
    call find_stiffness('.1,,M;.8,,S;.1,,M;', K)
    bending = (1 - 0.9_DP * 0.8_DP**3) / 12        ! over Q of M
    call suite%near('sandwich: core', K(1, 1, 2), even(1, 1, 1) / 2 * bending * 12 / 0.8_DP, 1.0e-11_DP)
    call suite%near('sandwich: skin', K(1, 1, 3), even(1, 1, 1) / 2 * bending * 12 / 0.1_DP, 1.0e-11_DP)
    call find_stiffness('.5,,M;.5,,S;', K)
    neutral = (0.5_DP * 0.25_DP + 0.05_DP * 0.75_DP) / 0.55_DP
    bending = 0.5_DP**3 / 12 * 1.1_DP + 0.5_DP * (0.25_DP - neutral)**2 + 0.05_DP * (0.75_DP - neutral)**2
    call suite%near('unsymmetric', K(2, 2, 1), even(2, 2, 1) * bending * 12, 1.0e-11_DP)
  end subroutine check_sandwich


  !> Fibres along one leg of the triangle, then along the other: directions 1 and 2 change places.
  subroutine check_turned()
    real(DP) :: along(2, 2, 5), across(2, 2, 5)
    call find_stiffness('.5,,W,0.;.5,,W,0.;', along)
    call find_stiffness('.5,,W,90.;.5,,W,90.;', across)
    call suite%that('stiff along the fibres', along(1, 1, 1) > 20 * along(2, 2, 1))
    call suite%near('turned: 11', across(1, 1, 1), along(2, 2, 1), 1.0e-11_DP)
    call suite%near('turned: 22', across(2, 2, 2), along(1, 1, 2), 1.0e-11_DP)
    call suite%near('turned: 12', across(1, 2, 1), along(1, 2, 1), 1.0e-11_DP)
  end subroutine check_turned


  !> One solid through the thickness has the bubble itself.
  subroutine check_whole()
    real(DP) :: K(2, 2, 5)
    call find_stiffness('1.,,M;', K, 1)
    call suite%that('one layer: none', all(abs(K) <= 0))
  end subroutine check_whole


  !> The stiffness of each layer of a section.
  subroutine find_stiffness(stack, K, n_whole)
    character(*), intent(in) :: stack
    real(DP), intent(out) :: K(2, 2, 5)            !< 0 past its layers
    integer, intent(in), optional :: n_whole       !< elements that are no layers of a stack; default 0
    type(model_type) :: model
    type(state_type) :: state
    type(diagnostic_list_type) :: messages
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(slave_state_type) :: no_slaves(0)
    type(integration_points_type) :: points
    integer :: e, n
    options%dialect = DIALECT_ABAQUS
    call read_deck_text(deck_lines(MODEL_PART // '*SHELL SECTION, ELSET=E, COMPOSITE;' // stack // &
      '*BOUNDARY;1,ENCASTRE;*STEP;*STATIC;*CLOAD;2,3,1.;*END STEP;'), options, model, messages, error)
    call suite%that('read ' // stack, .not. allocated(error))
    K = 0
    if (allocated(error)) return
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
    n = 0
    do e = 1, model%mesh%n_elements
      if (.not. is_stacked_triangle(model, e)) n = n + 1
      if (.not. is_stacked_triangle(model, e)) cycle
      call load_stack_bending(model, state, e, .false., points)
      K(:, :, e) = points%stack_bending
    end do
    if (present(n_whole)) then
      call suite%that('solids through the thickness', n == n_whole)
    else
      call suite%that('all are layers', n == 0)
    end if
  end subroutine find_stiffness

end program test_layer_stack
