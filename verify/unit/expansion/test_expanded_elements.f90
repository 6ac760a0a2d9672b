!> Unit test of amontons_expanded_elements: volumes, orientation and faces of the solids of all kinds, in both dialects.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_expanded_elements
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_expanded_elements, only: expanded_kind
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_tensor, only: determinant
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_S4R, KIND_S8R, KIND_C3D4, KIND_C3D8R, KIND_CSS8, &
    KIND_C3D20R, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,0,0;3,2,1,0;4,0,1,0;5,1,0,0;6,2,.5,0;7,1,1,0;8,0,.5,0;9,1,.5,0;' // &
    '*MATERIAL, NAME=M;*ELASTIC;100.,0.3;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_shells()
  call check_beams()
  call expect_message('*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;*SHELL SECTION, ELSET=E, MATERIAL=M;0.;', 'must be positive')
  call suite%that('abaqus: no hourglass', expanded_kind(KIND_S4R, .false.) == KIND_CSS8)
  call suite%that('calculix: one point', expanded_kind(KIND_S4R, .true.) == KIND_C3D8R)
  call suite%that('quadratic', expanded_kind(KIND_S8R, .true.) == KIND_C3D20R)
  call suite%that('a solid stays', expanded_kind(KIND_C3D4, .true.) == KIND_C3D4)
  call suite%finish()

contains

  !> Thickness 0.1 on an area of 2 (quadrilaterals) or 1 (triangles), with the nodes in the middle and on top.
  subroutine check_shells()
    character(*), parameter :: KINDS(6) = [character(3) :: 'S3', 'S4', 'S4R', 'S6', 'S8', 'S8R']
    character(*), parameter :: NODES(6) = [character(16) :: '1,2,4', '1,2,3,4', '1,2,3,4', '1,2,4,5,9,8', '1,2,3,4,5,6,7,8', &
      '1,2,3,4,5,6,7,8']
    real(DP), parameter :: AREA(6) = [real(DP) :: 1, 2, 2, 1, 2, 2]
    type(model_type) :: model
    integer :: i
    do i = 1, 6
      call expect_read('*ELEMENT, TYPE=' // trim(KINDS(i)) // ', ELSET=E;1,' // trim(NODES(i)) // &
        ';*SHELL SECTION, ELSET=E, MATERIAL=M;.1;', model)
      call suite%near(KINDS(i) // ' volume', volume(model), 0.1_DP * AREA(i), 1.0e-14_DP)
      call check_side(model, 1, -0.05_DP)
      call check_side(model, 2, 0.05_DP)
      call expect_read('*ELEMENT, TYPE=' // trim(KINDS(i)) // ', ELSET=E;1,' // trim(NODES(i)) // &
        ';*SHELL SECTION, ELSET=E, MATERIAL=M, OFFSET=SPOS;.1;', model)
      call check_side(model, 1, -0.1_DP)
      call check_side(model, 2, 0.0_DP)
    end do
  end subroutine check_shells


  !> A face lies in a plane z.
  subroutine check_side(model, face, z)
    type(model_type), intent(in) :: model
    integer, intent(in) :: face
    real(DP), intent(in) :: z
    type(element_kind_type) :: entry
    entry = element_kind(model%mesh%kind(1))
    associate (nodes => model%mesh%nodes(pack(entry%face_nodes(:, face), entry%face_nodes(:, face) > 0)))
      call suite%near(entry%name // ' side', maxval(abs(model%mesh%coordinates(3, nodes) - z)), 0.0_DP, 1.0e-15_DP)
    end associate
  end subroutine check_side


  !> A cross-section 0.1 x 0.2 on a length of 2; its third local axis is direction 1.
  subroutine check_beams()
    type(model_type) :: model
    integer :: i
    character(*), parameter :: KINDS(2) = ['B31', 'B32'], NODES(2) = [character(5) :: '1,2', '1,5,2']
    do i = 1, 2
      call expect_read('*ELEMENT, TYPE=' // KINDS(i) // ', ELSET=E;7,' // trim(NODES(i)) // &
        ';*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT;.1,.2;0,1,0;', model)
      call suite%near(KINDS(i) // ' volume', volume(model), 0.04_DP, 1.0e-15_DP)
      call suite%near('direction 1', sum(model%mesh%coordinates(2, model%mesh%nodes(5:8)) - &
        model%mesh%coordinates(2, model%mesh%nodes(1:4))), 0.4_DP, 1.0e-14_DP)
    end do
  end subroutine check_beams


  !> The volume of the first element; negative if it is turned inside out.
  real(DP) function volume(model)
    type(model_type), intent(in) :: model
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    type(element_kind_type) :: entry
    integer :: p, n_points
    entry = element_kind(model%mesh%kind(1))
    call quadrature(model%mesh%kind(1), n_points, xi, w)
    volume = 0
    do p = 1, n_points
      call shape_functions(model%mesh%kind(1), xi(:, p), N, dN)
      volume = volume + w(p) * determinant(matmul(model%mesh%coordinates(:, model%mesh%nodes(:entry%n_nodes)), &
        transpose(dN(:, :entry%n_nodes))))
    end do
  end function volume


  include 'sample_deck.inc'

end program test_expanded_elements
